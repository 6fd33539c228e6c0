use super::Claim;
pub(super) type Hook = Box<dyn Fn(usize, &Claim<'_>) + Send + Sync>;
