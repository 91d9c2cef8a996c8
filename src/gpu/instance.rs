//! The Vulkan instance, with validation on request, and what devices there are.

use super::capabilities::Capabilities;
use super::error::{Context, GpuError};
use ash::{ext, vk};
use std::ffi::{CStr, c_void};
use std::sync::{Arc, Mutex};

const VALIDATION_LAYER: &CStr = c"VK_LAYER_KHRONOS_validation";

/// What the validation layer said, in order.
type Messages = Mutex<Vec<String>>;

pub(super) struct Instance {
    /// Keeps the loader's library in memory.
    _entry: ash::Entry,
    pub raw: ash::Instance,
    debug: Option<(ext::debug_utils::Instance, vk::DebugUtilsMessengerEXT)>,
    /// The driver holds its address.
    messages: Arc<Messages>,
}

impl Instance {
    pub fn new(validation: bool) -> Result<Self, GpuError> {
        // SAFETY: the loader is a system library without initialisation of its own.
        let entry = unsafe { ash::Entry::load() }.map_err(|error| GpuError::NoLoader(error.to_string()))?;
        if validation && !has_layer(&entry)? {
            return Err(GpuError::NoValidationLayer);
        }
        let application = vk::ApplicationInfo::default().application_name(c"pathspace").api_version(vk::API_VERSION_1_2);
        let layers = [VALIDATION_LAYER.as_ptr()];
        let extensions = [ext::debug_utils::NAME.as_ptr()];
        let enabled = [vk::ValidationFeatureEnableEXT::SYNCHRONIZATION_VALIDATION];
        let mut features = vk::ValidationFeaturesEXT::default().enabled_validation_features(&enabled);
        let mut info = vk::InstanceCreateInfo::default().application_info(&application);
        if validation {
            info = info.enabled_layer_names(&layers).enabled_extension_names(&extensions).push_next(&mut features);
        }
        // SAFETY: every pointer of `info` outlives the call.
        let raw = match unsafe { entry.create_instance(&info, None) } {
            // So the loader says that it has found no driver.
            Err(vk::Result::ERROR_INCOMPATIBLE_DRIVER) => return Err(GpuError::NoDevice),
            other => other.context("create an instance")?,
        };
        let messages = Arc::new(Messages::default());
        let debug = if validation { Some(create_messenger(&entry, &raw, &messages)?) } else { None };
        Ok(Self { _entry: entry, raw, debug, messages })
    }

    pub fn messages(&self) -> Vec<String> {
        self.messages.lock().expect("no panic while holding it").clone()
    }

    /// Debug labels and object names, where validation is on.
    pub fn debug_device(&self, device: &ash::Device) -> Option<ext::debug_utils::Device> {
        self.debug.as_ref().map(|_| ext::debug_utils::Device::new(&self.raw, device))
    }

    pub fn physical_devices(&self) -> Result<Vec<(vk::PhysicalDevice, Capabilities)>, GpuError> {
        // SAFETY: the instance is alive.
        let devices = unsafe { self.raw.enumerate_physical_devices() }.context("list the devices")?;
        Ok(devices.into_iter().map(|device| (device, Capabilities::query(&self.raw, device))).collect())
    }
}

impl Drop for Instance {
    fn drop(&mut self) {
        // SAFETY: devices hold the instance alive, so nothing made from it is left.
        unsafe {
            if let Some((functions, messenger)) = &self.debug {
                functions.destroy_debug_utils_messenger(*messenger, None);
            }
            self.raw.destroy_instance(None);
        }
    }
}

/// Every Vulkan device of this machine, in the driver's order.
pub fn list_devices() -> Result<Vec<Capabilities>, GpuError> {
    Ok(Instance::new(false)?.physical_devices()?.into_iter().map(|(_, capabilities)| capabilities).collect())
}

fn has_layer(entry: &ash::Entry) -> Result<bool, GpuError> {
    // SAFETY: the entry is loaded.
    let layers = unsafe { entry.enumerate_instance_layer_properties() }.context("list the layers")?;
    Ok(layers.iter().any(|layer| layer.layer_name_as_c_str() == Ok(VALIDATION_LAYER)))
}

fn create_messenger(
    entry: &ash::Entry,
    instance: &ash::Instance,
    messages: &Arc<Messages>,
) -> Result<(ext::debug_utils::Instance, vk::DebugUtilsMessengerEXT), GpuError> {
    let info = vk::DebugUtilsMessengerCreateInfoEXT::default()
        .message_severity(vk::DebugUtilsMessageSeverityFlagsEXT::WARNING | vk::DebugUtilsMessageSeverityFlagsEXT::ERROR)
        .message_type(vk::DebugUtilsMessageTypeFlagsEXT::VALIDATION)
        .pfn_user_callback(Some(on_message))
        .user_data(Arc::as_ptr(messages).cast_mut().cast());
    let functions = ext::debug_utils::Instance::new(entry, instance);
    // SAFETY: the user data is owned by the Instance, which destroys the messenger before it.
    let messenger = unsafe { functions.create_debug_utils_messenger(&info, None) }.context("listen to the validation layer")?;
    Ok((functions, messenger))
}

unsafe extern "system" fn on_message(
    _severity: vk::DebugUtilsMessageSeverityFlagsEXT,
    _types: vk::DebugUtilsMessageTypeFlagsEXT,
    data: *const vk::DebugUtilsMessengerCallbackDataEXT<'_>,
    user: *mut c_void,
) -> vk::Bool32 {
    // SAFETY: the layer passes valid data, and the user data that create_messenger gave it.
    let (message, messages) = unsafe { (CStr::from_ptr((*data).p_message), &*user.cast::<Messages>()) };
    let message = message.to_string_lossy().into_owned();
    tracing::error!(target: "vulkan", "{message}");
    if let Ok(mut messages) = messages.lock() {
        messages.push(message);
    }
    vk::FALSE
}
