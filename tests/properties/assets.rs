//! What lies in assets/ is whole, and shows what it is there to show.

use exr::prelude::{ReadChannels, ReadLayers, read};
use pathspace::scene::effects::{Effect, EffectSet};
use pathspace::scene::gltf;
use std::collections::HashMap;
use std::path::{Path, PathBuf};

fn assets(folder: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("assets").join(folder)
}

fn channels(path: &Path) -> HashMap<String, Vec<f32>> {
    let image =
        read().no_deep_data().largest_resolution_level().all_channels().first_valid_layer().all_attributes().from_file(path).unwrap();
    image.layer_data.channel_data.list.iter().map(|c| (c.name.to_string(), c.sample_data.values_as_f32().collect())).collect()
}

#[test]
fn the_still_life_loads_without_a_warning_and_shows_every_feature_that_it_was_made_for() {
    let scene = gltf::load(&assets("scenes/still_life.glb")).unwrap();
    assert_eq!(scene.warnings, []);
    assert!(scene.instances.len() > scene.meshes.len());
    let effects = EffectSet::derive(&scene);
    use Effect::*;
    for effect in [Glossy, Mirror, SmoothTransmission, Textures, AlphaMask, SphereLight, EmissiveLight, ObjectAnimation] {
        assert!(effects.contains(effect), "{}", effect.name());
    }
}

#[test]
fn every_reference_has_a_mean_and_a_small_standard_error_in_every_pixel_and_says_where_it_comes_from() {
    let descriptions: Vec<PathBuf> = std::fs::read_dir(assets("references"))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "json"))
        .collect();
    assert!(!descriptions.is_empty());
    for path in descriptions {
        let about: serde_json::Value = serde_json::from_slice(&std::fs::read(&path).unwrap()).unwrap();
        assert!(about["renderer"].as_str().unwrap().starts_with("Mitsuba"), "{}", path.display());
        let channels = channels(&path.with_extension("exr"));
        for color in ["R", "G", "B"] {
            let (mean, error) = (&channels[color], &channels[&format!("error.{color}")]);
            assert_eq!(mean.len() as u64, about["size"][0].as_u64().unwrap() * about["size"][1].as_u64().unwrap());
            assert!(mean.iter().chain(error).all(|&value| value.is_finite() && value >= 0.0), "{}", path.display());
            let total = |values: &[f32]| values.iter().map(|&value| f64::from(value)).sum::<f64>();
            assert!(total(error) < 0.05 * total(mean), "{}", path.display());
        }
    }
}
