//! What a page shows of a fit, beside the beat of the fitted cell.

use super::curves::rounded;
use super::given::PageFit;
use crate::figure::{Figure, FittedCurve, LikelihoodProfile, Theme};
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use serde::Serialize;

#[derive(Serialize)]
pub(super) struct FitData<'a> {
    verdict: &'a str,
    headline: &'a str,
    estimates: &'a [super::FittedNumber],
    curves: Vec<CurveData<'a>>,
    profiles: Vec<ProfileData<'a>>,
    notes: &'a [String],
    figures: Vec<FigureData<'a>>,
}

#[derive(Serialize)]
struct CurveData<'a> {
    label: &'a str,
    unit: &'a str,
    t_ms: Vec<f64>,
    /// Of the frames that counted, and of the others.
    measured: Vec<Option<f64>>,
    left_out: Vec<Option<f64>>,
    fitted: Vec<Option<f64>>,
    residual: Vec<Option<f64>>,
    noise: f64,
}

#[derive(Serialize)]
struct ProfileData<'a> {
    label: &'a str,
    value: f64,
    interval: [Option<f64>; 2],
    points: Vec<[f64; 2]>,
    at_ends: f64,
}

#[derive(Serialize)]
struct FigureData<'a> {
    title: &'a str,
    light: String,
    dark: String,
    words: &'a str,
    notes: &'a [String],
}

pub(super) fn of<'a>(fit: &'a PageFit<'_>) -> FitData<'a> {
    FitData {
        verdict: fit.verdict,
        headline: fit.headline,
        estimates: fit.estimates,
        curves: fit.curves.iter().map(curve).collect(),
        profiles: fit.profiles.iter().map(profile).collect(),
        notes: fit.notes,
        figures: fit
            .figures
            .iter()
            .map(|it| FigureData {
                title: it.title,
                light: image(&it.figure.clone().themed(Theme::Light)),
                dark: image(&it.figure.clone().themed(Theme::Dark)),
                words: &it.words,
                notes: it.notes,
            })
            .collect(),
    }
}

fn curve(curve: &FittedCurve) -> CurveData<'_> {
    let finite = |value: f64| Some(rounded(value)).filter(|value| value.is_finite());
    let frames = || curve.measured.iter().zip(&curve.used);
    let counted = |wanted: bool| {
        frames().map(|(value, used)| finite(*value).filter(|_| *used == wanted)).collect()
    };
    let left = curve.measured.iter().zip(&curve.fitted).zip(&curve.used);
    CurveData {
        label: &curve.label,
        unit: &curve.unit,
        t_ms: curve.times_ms.iter().map(|time| rounded(*time)).collect(),
        measured: counted(true),
        left_out: counted(false),
        fitted: curve.fitted.iter().map(|value| finite(*value)).collect(),
        residual: left.map(|((a, b), used)| finite(a - b).filter(|_| *used)).collect(),
        noise: curve.noise,
    }
}

fn profile(profile: &LikelihoodProfile) -> ProfileData<'_> {
    let LikelihoodProfile { label, value, interval, points, at_ends } = profile;
    let points = points.iter().map(|point| point.map(rounded)).collect();
    ProfileData { label, value: *value, interval: *interval, points, at_ends: *at_ends }
}

/// A figure as the address of an image, so that nothing in it can act on the page.
fn image(figure: &Figure) -> String {
    format!("data:image/svg+xml;base64,{}", STANDARD.encode(figure.to_svg()))
}
