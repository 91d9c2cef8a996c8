use ash::vk;

/// What can go wrong between the program and the device.
#[derive(Debug, thiserror::Error)]
pub enum GpuError {
    #[error("no Vulkan loader was found ({0}); install it (Debian and Ubuntu: libvulkan1) or run ci/setup")]
    NoLoader(String),
    #[error("no Vulkan device was found; install a driver (Debian and Ubuntu: mesa-vulkan-drivers) or run ci/setup")]
    NoDevice,
    #[error("no Vulkan device is called '{wanted}'; there are: {found}")]
    UnknownDevice { wanted: String, found: String },
    #[error("device '{device}' lacks {missing}; a newer driver may offer it, `pathspace devices` lists what else there is")]
    MissingFeatures { device: String, missing: String },
    #[error("the validation layer is not installed; install it (Debian and Ubuntu: vulkan-validationlayers) or run ci/setup")]
    NoValidationLayer,
    #[error("Vulkan could not {what}: {result}")]
    Vulkan { what: String, result: vk::Result },
    #[error("no memory for {what} ({bytes} bytes): {message}; choose a smaller --size, or a smaller scene")]
    Memory { what: String, bytes: u64, message: String },
    #[error("'{what}' has {width}x{height} texels, and device '{device}' takes at most {most} a side; choose a smaller --size or texture")]
    TooLarge { what: String, width: u32, height: u32, device: String, most: u32 },
    #[error("there is no shader '{0}'")]
    UnknownShader(String),
    #[error(transparent)]
    Compile(#[from] shader_compiler::CompileError),
    #[error("shader '{shader}': {message}")]
    Interface { shader: String, message: String },
    #[error("the device '{device}' was lost; the driver may have reset it after a long-running frame: try a smaller --size or --spp")]
    Lost { device: String },
}

/// Names the operation in the error of a Vulkan call.
pub(super) trait Context<T> {
    fn context(self, what: &str) -> Result<T, GpuError>;
}

impl<T> Context<T> for Result<T, vk::Result> {
    fn context(self, what: &str) -> Result<T, GpuError> {
        self.map_err(|result| GpuError::Vulkan { what: what.to_owned(), result })
    }
}
