//! STUB
use super::record::Figure;
use crate::technique::Timings;
pub fn figures(_: &Timings, _: [u32; 2]) -> std::collections::BTreeMap<String, Figure> {
    Default::default()
}
