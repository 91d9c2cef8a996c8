//! What a device cannot hold is refused with its name, its size and the limit, before the driver is asked for it.

use crate::common;
use pathspace::gpu::{GpuError, ImageInfo, vk};

#[test]
fn an_image_larger_than_the_device_takes_is_refused() {
    let gpu = common::gpu();
    let most = gpu.capabilities().max_image_side;
    let image = |extent| gpu.create_image("film", ImageInfo::storage(vk::Format::R32_UINT, extent));
    assert!(image([most, 1]).is_ok());
    for extent in [[most + 1, 1], [1, most + 1]] {
        let error = image(extent).map(|_| ()).unwrap_err();
        assert!(matches!(error, GpuError::TooLarge { .. }), "{error}");
        assert!(error.to_string().contains(&format!("'film' has {}x{} texels", extent[0], extent[1])), "{error}");
    }
}
