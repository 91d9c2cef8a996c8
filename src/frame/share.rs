//! A frame in several submissions: how its samples per pixel are shared out.

/// What one submission takes of a frame's samples per pixel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Share {
    /// Samples of the frame that earlier submissions have taken of every pixel.
    pub begin: u32,
    /// That all of them have taken after this one; of the last one the largest number of any pixel.
    pub end: u32,
    /// The frame's last.
    pub ends: bool,
}

impl Share {
    /// The frame's first.
    pub fn begins(self) -> bool {
        self.begin == 0
    }

    /// Of the pixels that take most.
    pub fn samples(self) -> u32 {
        self.end - self.begin
    }
}

/// All of a frame, in order. `samples` per pixel, at least 1; of a fraction, some pixels take one more. `most` in one submission, at least 1;
/// the last one may take one more, so that every pixel has a sample in each.
pub fn shares(samples: f64, most: u32) -> impl Iterator<Item = Share> {
    let (whole, all) = (samples as u32, samples.ceil() as u32);
    let last = whole.div_ceil(most) - 1;
    (0..=last).map(move |index| {
        let ends = index == last;
        Share { begin: index * most, end: if ends { all } else { (index + 1) * most }, ends }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_follow_each_other_to_the_end_of_the_frame() {
        for (samples, most, count) in [(1.0, 1, 1), (1.5, 1, 1), (2.5, 1, 2), (40.0, 7, 6), (42.0, 7, 6), (42.25, 7, 6), (4e9, u32::MAX, 1)]
        {
            let all: Vec<Share> = shares(samples, most).collect();
            assert_eq!((all.len(), all[0].begin, all[count - 1].end), (count, 0, samples.ceil() as u32));
            assert!(all.iter().enumerate().all(|(i, share)| share.begins() == (i == 0) && share.ends == (i + 1 == count)));
            assert!(all.windows(2).all(|pair| pair[0].end == pair[1].begin && pair[0].samples() == most));
            assert!(all[count - 1].begin < samples as u32, "a pixel has no sample in the last one");
        }
    }
}
