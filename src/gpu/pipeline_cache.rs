//! The pipeline cache, kept on disk per device and driver. A cache that cannot be read or written is no error.

use super::capabilities::Capabilities;
use super::error::{Context, GpuError};
use ash::vk;
use std::io::Write;
use std::path::PathBuf;

pub(super) struct PipelineCache {
    device: ash::Device,
    raw: vk::PipelineCache,
    path: Option<PathBuf>,
    loaded: usize,
}

impl PipelineCache {
    pub fn load(device: &ash::Device, capabilities: &Capabilities) -> Result<Self, GpuError> {
        let uuid: String = capabilities.pipeline_cache_uuid.iter().map(|byte| format!("{byte:02x}")).collect();
        let path = dirs::cache_dir().map(|dir| dir.join("pathspace").join(format!("pipelines-{uuid}.bin")));
        let data = path.as_ref().and_then(|path| std::fs::read(path).ok()).unwrap_or_default();
        let info = vk::PipelineCacheCreateInfo::default().initial_data(&data);
        // SAFETY: drivers check the data's header themselves and start empty where it does not fit.
        let raw = unsafe { device.create_pipeline_cache(&info, None) }.context("create the pipeline cache")?;
        Ok(Self { device: device.clone(), raw, path, loaded: data.len() })
    }

    pub fn raw(&self) -> vk::PipelineCache {
        self.raw
    }

    fn save(&self) -> Option<()> {
        let path = self.path.as_ref()?;
        // SAFETY: the cache is alive.
        let data = unsafe { self.device.get_pipeline_cache_data(self.raw) }.ok()?;
        if data.len() == self.loaded {
            return None;
        }
        let directory = path.parent()?;
        std::fs::create_dir_all(directory).ok()?;
        let mut file = tempfile::NamedTempFile::new_in(directory).ok()?;
        file.write_all(&data).ok()?;
        file.persist(path).ok().map(|_| ())
    }
}

impl Drop for PipelineCache {
    fn drop(&mut self) {
        self.save();
        // SAFETY: no pipeline is being created.
        unsafe { self.device.destroy_pipeline_cache(self.raw, None) };
    }
}
