//! Where measurements were made.

use super::record::Provenance;
use crate::gpu::Capabilities;
use sysinfo::{CpuRefreshKind, RefreshKind, System};

impl Provenance {
    /// Of this program on this machine; `seeds` and `time` are the measurement's own.
    pub fn here(device: &Capabilities) -> Self {
        let system = System::new_with_specifics(RefreshKind::nothing().with_cpu(CpuRefreshKind::nothing()));
        let cpu = system.cpus().first().map(|cpu| cpu.brand().trim().to_owned());
        let unknown = || "unknown".to_owned();
        Self {
            commit: env!("PATHSPACE_COMMIT").to_owned(),
            program: concat!("pathspace ", env!("CARGO_PKG_VERSION")).to_owned(),
            device: device.name.clone(),
            driver: device.driver.clone(),
            machine: System::host_name().unwrap_or_else(unknown),
            cpu: cpu.filter(|brand| !brand.is_empty()).unwrap_or_else(unknown),
            cores: std::thread::available_parallelism().map_or(0, |count| count.get() as u32),
            os: System::long_os_version().unwrap_or_else(unknown),
            time: String::new(),
            seeds: Vec::new(),
        }
    }

    /// The same, made now.
    pub fn now(&self, seeds: Vec<u32>) -> Self {
        Self { time: jiff::Timestamp::now().round(jiff::Unit::Second).unwrap_or(jiff::Timestamp::now()).to_string(), seeds, ..self.clone() }
    }
}
