//! Error measures rank pictures as a person would, and the tests of statistics/ keep the false-alarm rate that they state.

use super::random::normal;
use pathspace::bench::figure::{FIGURES, Group};
use pathspace::display::{Image, ToneMapping};
use pathspace::metrics::accuracy::{Reference, Shot};
use pathspace::metrics::statistics::{BatchMeans, chi_square_test};
use pathspace::metrics::z_test::{Estimate, z_test};
use pathspace::metrics::{Pair, accuracy, flip, hdr_flip, mean_ratio, mse, psnr, relmse, ssim};
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg32;

const SIZE: u32 = 24;

fn smooth_picture() -> Image {
    let pixel = |i: u32| [0.1 + (i % SIZE) as f32 / 32.0, 0.2 + (i / SIZE) as f32 / 64.0, 0.5];
    Image::new(SIZE, SIZE, (0..SIZE * SIZE).map(pixel).collect())
}

fn noisy(image: &Image, amplitude: f64, seed: u64) -> Image {
    let mut rng = Pcg32::seed_from_u64(seed);
    let pixels = image.pixels.iter().map(|pixel| pixel.map(|value| (f64::from(value) * (1.0 + amplitude * normal(&mut rng))) as f32));
    Image::new(image.width, image.height, pixels.collect())
}

/// Each measure as an error: 0 is perfect, more is worse.
fn errors(image: &Image, reference: &Image) -> [f64; 5] {
    let mapping = ToneMapping::default();
    let encoded = [mapping.encoded(image), mapping.encoded(reference)];
    let (radiance, encoded) = (Pair::new(image, reference).unwrap(), Pair::new(&encoded[0], &encoded[1]).unwrap());
    let psnr_as_error = (-psnr(&encoded) / 10.0).exp2();
    [mse(&radiance), relmse(&radiance, 0.0), psnr_as_error, 1.0 - ssim(&encoded).unwrap(), flip(&encoded).mean()]
}

#[test]
fn equal_pictures_have_no_error() {
    let image = noisy(&smooth_picture(), 0.3, 1);
    for error in errors(&image, &image) {
        assert!(error.abs() < 1e-12, "{error}");
    }
    assert_eq!(mean_ratio(&Pair::new(&image, &image).unwrap()), 1.0);
}

/// NVIDIA's own code takes bytes alone: 6 random pictures of them, each pixel's error within 1e-4.
#[test]
fn flip_agrees_with_its_authors_code_at_every_pixel() {
    let mut rng = Pcg32::seed_from_u64(7);
    for (width, height) in [(1, 1), (5, 40), (16, 16), (37, 23), (64, 3), (50, 50)] {
        let mut bytes = || (0..width * height * 3).map(|_| rng.random::<u8>()).collect::<Vec<u8>>();
        let [reference, test] = [bytes(), bytes()];
        let theirs = [&reference, &test].map(|bytes| nv_flip::FlipImageRgb8::with_data(width, height, bytes));
        let [theirs_reference, theirs_test] = theirs;
        let theirs = nv_flip::flip(theirs_reference, theirs_test, nv_flip::pixels_per_degree(0.7, 3840.0, 0.7)).to_vec();
        let image = |bytes: &[u8]| {
            let pixels = bytes.chunks(3).map(|pixel| [0, 1, 2].map(|channel: usize| f32::from(pixel[channel]) / 255.0));
            Image::new(width, height, pixels.collect())
        };
        let ours = flip(&Pair::new(&image(&test), &image(&reference)).unwrap());
        let worst = ours.errors.iter().zip(&theirs).map(|(ours, theirs)| (ours - f64::from(*theirs)).abs()).fold(0.0, f64::max);
        assert!(worst < 1e-4, "{width}x{height}: {worst}");
    }
}

/// An error in the dark that ACES' own exposure hides shows at a longer one, and not the other way round.
#[test]
fn hdr_flip_sees_in_the_dark() {
    let mut reference = smooth_picture();
    reference.pixels.iter_mut().enumerate().for_each(|(i, pixel)| *pixel = if i < 100 { [1e3; 3] } else { [1e-3; 3] });
    let mut image = reference.clone();
    image.pixels[300..400].iter_mut().for_each(|pixel| *pixel = [2e-3; 3]);
    let mapping = ToneMapping::default();
    let encoded = [mapping.encoded(&image), mapping.encoded(&reference)];
    let ldr = flip(&Pair::new(&encoded[0], &encoded[1]).unwrap());
    let hdr = hdr_flip(&Pair::new(&image, &reference).unwrap());
    assert!(hdr.mean() > 5.0 * ldr.mean(), "{} {}", hdr.mean(), ldr.mean());
}

fn shots(images: &[Image]) -> Vec<Shot<'_>> {
    images.iter().map(|last| Shot { last, before: Some(&images[0]) }).collect()
}

#[test]
fn accuracy_has_every_figure_of_its_groups_and_no_other() {
    let truth = smooth_picture();
    let images: Vec<Image> = (0..3).map(|seed| noisy(&truth, 0.2, 10 + seed)).collect();
    let variance = Image::new(SIZE, SIZE, vec![[1e-6; 3]; truth.pixels.len()]);
    let reference = Reference { mean: &truth, variance: Some(&variance), before: Some(&truth) };
    let figures = accuracy(&shots(&images), &reference, &ToneMapping::default()).unwrap();
    let groups = [Group::Error, Group::Split, Group::Temporal, Group::Fault, Group::Reference];
    let mut expected: Vec<&str> = FIGURES.iter().filter(|figure| groups.contains(&figure.group)).map(|figure| figure.key).collect();
    expected.sort_unstable();
    assert_eq!(figures.keys().copied().collect::<Vec<_>>(), expected);
    for (key, estimate) in &figures {
        assert!(estimate.low <= estimate.value && estimate.value <= estimate.high, "{key}: {estimate:?}");
        assert_eq!(estimate.samples.len(), if *key == "reference_radiance" { 0 } else { 3 }, "{key}");
    }
    let ratio = (figures["relmse"].value / relmse(&Pair::new(&images[0], &truth).unwrap(), 0.0) - 1.0).abs();
    assert!(ratio < 0.2, "the mean of three like seeds is near one's: {ratio}");
}

/// By hand: 6 standard errors of 0.2, of which each pixel's three add up: 0.2 / sqrt(2) for the mean.
#[test]
fn the_radiance_of_a_reference_is_as_uncertain_as_its_pixels() {
    let [mean, variance] = [3.0, 0.04].map(|value| Image::new(2, 1, vec![[value; 3]; 2]));
    let reference = Reference { mean: &mean, variance: Some(&variance), before: None };
    let figures = accuracy(&[Shot { last: &mean, before: None }], &reference, &ToneMapping::default()).unwrap();
    let reach = 1.96 * 0.2 / 2f64.sqrt();
    let radiance = &figures["reference_radiance"];
    let errors = [radiance.value - 3.0, radiance.low - (3.0 - reach), radiance.high - (3.0 + reach)];
    assert!(errors.iter().all(|error| error.abs() < 1e-4), "{radiance:?}");
}

#[test]
fn accuracy_counts_what_is_not_finite_and_goes_on_without_it() {
    let truth = smooth_picture();
    let mut images: Vec<Image> = (0..2).map(|seed| noisy(&truth, 0.1, 20 + seed)).collect();
    images[0].pixels[3] = [f32::NAN, 0.1, 0.1];
    images[1].pixels[4] = [f32::INFINITY, -1.0, 0.1];
    images[1].pixels[5] = [0.1, -1.0, 0.1];
    let reference = Reference { mean: &truth, variance: None, before: None };
    let figures = accuracy(&shots(&images), &reference, &ToneMapping::default()).unwrap();
    assert_eq!(["nan", "infinite", "negative"].map(|key| figures[key].value), [1.0, 1.0, 2.0]);
    assert!(figures.values().all(|estimate| estimate.value.is_finite()));
    assert!(!figures.contains_key("reference_ratio"), "an exact reference has no noise to compare with");
}

#[test]
fn accuracy_of_one_perfect_seed_leaves_out_what_has_no_value() {
    let truth = smooth_picture();
    let reference = Reference { mean: &truth, variance: None, before: None };
    let shot = Shot { last: &truth, before: None };
    let figures = accuracy(&[shot], &reference, &ToneMapping::default()).unwrap();
    for key in ["psnr", "bias2", "variance", "temporal"] {
        assert!(!figures.contains_key(key), "{key}");
    }
    assert_eq!((figures["energy"].low, figures["energy"].high, figures["hdr_flip"].value), (1.0, 1.0, 0.0));
    assert!(accuracy(&[], &reference, &ToneMapping::default()).is_err());
}

#[test]
fn every_error_grows_with_noise() {
    let reference = smooth_picture();
    let levels = [0.01, 0.05, 0.2].map(|amplitude| errors(&noisy(&reference, amplitude, 2), &reference));
    for measure in 0..5 {
        let errors = levels.map(|level| level[measure]);
        assert!(errors[0] > 0.0 && errors.is_sorted(), "measure {measure}: {errors:?}");
    }
}

/// An error relative to the reference does not depend on the unit of light, as long as the reference is far above 0.1.
#[test]
fn relmse_ignores_the_unit_of_light() {
    let scaled = |image: &Image, scale: f32| Image::new(SIZE, SIZE, image.pixels.iter().map(|pixel| pixel.map(|v| v * scale)).collect());
    let (image, reference) = (noisy(&smooth_picture(), 0.1, 3), smooth_picture());
    let at = |scale| relmse(&Pair::new(&scaled(&image, scale), &scaled(&reference, scale)).unwrap(), 0.0);
    assert!((at(1e3) / at(1e5) - 1.0).abs() < 1e-4, "{} {}", at(1e3), at(1e5));
}

/// Mean and variance images of `batches` batches whose noise is a tenth of `truth`.
fn rendering(truth: &Image, batches: u64, rng: &mut Pcg32) -> [Image; 2] {
    let mut statistics = vec![[BatchMeans::default(); 3]; truth.pixels.len()];
    for (pixel, statistics) in truth.pixels.iter().zip(&mut statistics) {
        for (value, statistics) in pixel.iter().zip(statistics) {
            *statistics = (0..batches).map(|_| f64::from(*value) * (1.0 + 0.1 * normal(rng))).collect();
        }
    }
    let image = |value: fn(&BatchMeans) -> f64| {
        let pixels = statistics.iter().map(|pixel| pixel.each_ref().map(|statistics| value(statistics) as f32));
        Image::new(truth.width, truth.height, pixels.collect())
    };
    [image(|statistics| statistics.mean), image(BatchMeans::variance_of_mean)]
}

fn passes(truth: [&Image; 2], batches: u64, block: u32, significance: f64, rng: &mut Pcg32) -> bool {
    let [a, b] = truth.map(|truth| rendering(truth, batches, rng));
    let [a, b] = [&a, &b].map(|[mean, variance]| Estimate { mean, variance, batches: Some(batches) });
    z_test(a, b, block, significance).unwrap().passed()
}

/// 200 comparisons at a significance of 0.2 raise 40 false alarms on average. Fewer than 17 or more than 63 (4 standard
/// deviations of 5.66) would come by chance once in 15,000 changes of the seed, for each block size.
#[test]
fn z_test_keeps_its_false_alarm_rate() {
    let truth = Image::new(8, 8, smooth_picture().pixels[..64].to_vec());
    for block in [1, 3] {
        let mut rng = Pcg32::seed_from_u64(4);
        let alarms = (0..200).filter(|_| !passes([&truth, &truth], 16, block, 0.2, &mut rng)).count();
        assert!((17..=63).contains(&alarms), "block {block}: {alarms} alarms");
    }
}

/// 10 % in one pixel of 576 are 11 standard errors at 256 batches; 1 % everywhere is 1.1 in each pixel, and shows only in
/// blocks: 9 in those of 8x8. The middle comparison, of 1728 tests near 1.1, would fail by chance once in 100.
#[test]
fn z_test_sees_small_errors_in_blocks_and_large_ones_in_pixels() {
    let truth = smooth_picture();
    let mut rng = Pcg32::seed_from_u64(5);
    let mut one_pixel_wrong = truth.clone();
    one_pixel_wrong.pixels[100] = truth.pixels[100].map(|value| value * 1.1);
    assert!(!passes([&one_pixel_wrong, &truth], 256, 1, 0.01, &mut rng));
    let darker = Image::new(SIZE, SIZE, truth.pixels.iter().map(|pixel| pixel.map(|value| value * 0.99)).collect());
    assert!(passes([&darker, &truth], 256, 1, 0.01, &mut rng));
    assert!(!passes([&darker, &truth], 256, 8, 0.01, &mut rng));
}

/// 400 samples of a skewed distribution, tested at 0.05: 20 alarms on average; more than 39 or fewer than 3 (4 standard
/// deviations of 4.36) would come by chance once in 15,000 changes of the seed.
#[test]
fn chi_square_keeps_its_false_alarm_rate_on_unequal_cells() {
    let probabilities: Vec<f64> = (1..=40).map(|i| f64::from(i * i) / 22140.0).collect();
    let mut rng = Pcg32::seed_from_u64(6);
    let p_value = |rng: &mut Pcg32| {
        let mut counts = vec![0u64; 40];
        for _ in 0..1000 {
            let mut left = rng.random::<f64>();
            let cell = probabilities.iter().position(|p| (left < *p, left -= p).0).unwrap_or(39);
            counts[cell] += 1;
        }
        chi_square_test(&counts, &probabilities.iter().map(|p| p * 1000.0).collect::<Vec<_>>()).p_value
    };
    let alarms = (0..400).filter(|_| p_value(&mut rng) < 0.05).count();
    assert!((3..=39).contains(&alarms), "{alarms} alarms");
}
