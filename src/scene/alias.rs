//! Walker's alias method: a choice in proportion to weights with one table look-up. `alias_choice` in `shaders_glsl/lib/sampling.glsl` reads it.

use crate::shared::AliasEntry;

/// Builds tables, and keeps its memory for the next one.
#[derive(Debug, Clone, Default)]
pub struct AliasBuilder {
    scaled: Vec<f64>,
    small: Vec<u32>,
    large: Vec<u32>,
}

impl AliasBuilder {
    /// Fills `table`, one entry for each of `weights` (finite, not negative), and returns their sum. What has no weight is never
    /// chosen; if nothing has, the table is empty. Vose, "A Linear Algorithm for Generating Random Numbers with a Given Distribution", 1991.
    pub fn build(&mut self, weights: &[f64], table: &mut Vec<AliasEntry>) -> f64 {
        let sum: f64 = weights.iter().sum();
        table.clear();
        if sum <= 0.0 {
            return 0.0;
        }
        let scale = weights.len() as f64 / sum;
        self.scaled.clear();
        self.scaled.extend(weights.iter().map(|weight| weight * scale));
        table.extend((0..weights.len() as u32).map(|alias| AliasEntry { threshold: 1.0, alias }));
        self.small.clear();
        self.large.clear();
        for (i, &share) in self.scaled.iter().enumerate() {
            if share < 1.0 { self.small.push(i as u32) } else { self.large.push(i as u32) }
        }
        self.pair_up(table);
        // Rounding may leave buckets that are full but for the last digit; those of no weight must stay empty all the same.
        let heaviest = (0..weights.len()).max_by(|&a, &b| weights[a].total_cmp(&weights[b])).unwrap_or(0) as u32;
        for &left in self.small.iter().filter(|&&left| weights[left as usize] == 0.0) {
            table[left as usize] = AliasEntry { threshold: 0.0, alias: heaviest };
        }
        sum
    }

    /// Fills each bucket that has less than its share from one that has more.
    fn pair_up(&mut self, table: &mut [AliasEntry]) {
        while let (Some(&giver), Some(taker)) = (self.large.last(), self.small.pop()) {
            let share = self.scaled[taker as usize];
            table[taker as usize] = AliasEntry { threshold: share as f32, alias: giver };
            let left = &mut self.scaled[giver as usize];
            *left -= 1.0 - share;
            if *left < 1.0 {
                self.large.pop();
                self.small.push(giver);
            }
        }
    }
}

/// The probability with which a table chooses each entry.
#[cfg(test)]
fn probabilities(table: &[AliasEntry]) -> Vec<f64> {
    let mut chosen = vec![0.0; table.len()];
    for (bucket, entry) in table.iter().enumerate() {
        chosen[bucket] += f64::from(entry.threshold) / table.len() as f64;
        chosen[entry.alias as usize] += (1.0 - f64::from(entry.threshold)) / table.len() as f64;
    }
    chosen
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{Rng, SeedableRng};
    use rand_pcg::Pcg32;

    fn assert_exact(weights: &[f64]) {
        let mut table = Vec::new();
        let sum = AliasBuilder::default().build(weights, &mut table);
        for (i, (&weight, chosen)) in weights.iter().zip(probabilities(&table)).enumerate() {
            // A bucket's threshold is rounded to single precision: half a unit in the last place, for each bucket that gives to i.
            let givers = table.iter().filter(|entry| entry.alias == i as u32).count();
            let tolerance = (givers + 1) as f64 * f64::from(f32::EPSILON) / table.len() as f64;
            assert!((chosen - weight / sum).abs() <= tolerance, "entry {i}: {chosen} for {}", weight / sum);
            assert!(weight > 0.0 || chosen == 0.0, "entry {i} of no weight is chosen");
        }
    }

    #[test]
    fn every_entry_is_chosen_in_proportion_to_its_weight() {
        let mut rng = Pcg32::seed_from_u64(1);
        for count in [1, 2, 3, 10, 1000] {
            let weights: Vec<f64> = (0..count).map(|_| rng.random_range(0.0..1.0f64).powi(8)).collect();
            assert_exact(&weights);
        }
    }

    #[test]
    fn what_has_no_weight_is_never_chosen() {
        assert_exact(&[0.0, 1.0, 0.0, 0.0, 0.1, 0.0]);
        assert_exact(&[1e-300, 0.0, 1e300, 0.0]);
        let mut table = vec![AliasEntry::default()];
        assert_eq!(AliasBuilder::default().build(&[0.0, 0.0], &mut table), 0.0);
        assert!(table.is_empty());
    }
}
