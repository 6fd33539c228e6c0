//! The protocol section: one event, once or repeated.

use crate::draft::ProtocolPulse;

/// The pulse of a protocol with one event; `None` for another protocol.
pub(super) fn parse(lines: &[&str]) -> Option<ProtocolPulse> {
    let mut events = lines
        .iter()
        .map(|line| line.split('#').next().unwrap_or("").trim())
        .filter(|line| !line.is_empty());
    let event = events.next()?;
    if events.next().is_some() {
        return None;
    }
    let numbers: Option<Vec<f64>> =
        event.split_whitespace().map(|word| word.parse().ok()).collect();
    let &[level, _start, duration, period, _] = numbers?.as_slice() else { return None };
    let period = (period > 0.0 && period.is_finite()).then_some(period);
    (level.is_finite() && duration > 0.0 && duration.is_finite()).then_some(ProtocolPulse {
        level,
        duration,
        period,
    })
}
