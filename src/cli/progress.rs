//! A progress bar on stderr: samples done, time left, error estimate. Hidden when stderr is no terminal, or by `-q`.

use indicatif::{MultiProgress, ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::Write;
use std::sync::LazyLock;

static BARS: LazyLock<MultiProgress> = LazyLock::new(MultiProgress::new);

/// Shows no bar from here on.
pub fn hide() {
    BARS.set_draw_target(ProgressDrawTarget::hidden());
}

/// One long piece of work; its bar goes away when dropped.
pub struct Progress {
    bar: ProgressBar,
}

impl Progress {
    /// `unit` names what `total` counts, such as "samples".
    pub fn new(what: &str, total: u64, unit: &str) -> Progress {
        let bar = BARS.add(ProgressBar::new(total));
        let template = format!("{{prefix}} {{wide_bar}} {{human_pos}}/{{human_len}} {unit}, {{eta}} left{{msg}}");
        bar.set_style(ProgressStyle::with_template(&template).unwrap_or_else(|_| ProgressStyle::default_bar()));
        bar.set_prefix(what.to_owned());
        Progress { bar }
    }

    pub fn advance(&self, done: u64) {
        self.bar.inc(done);
    }

    /// So much is done in all.
    pub fn reach(&self, done: u64) {
        self.bar.set_position(done);
    }

    /// What is being done now.
    pub fn what(&self, what: &str) {
        self.bar.set_message(format!(", {what}"));
    }

    /// Standard error of the picture's mean, relative to that mean.
    pub fn error_estimate(&self, relative: f64) {
        self.bar.set_message(format!(", error {:.2} %", relative * 100.0));
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

/// Stderr for the log: lines come above the bar instead of through it.
pub struct BarAwareStderr;

impl Write for BarAwareStderr {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        BARS.suspend(|| std::io::stderr().write(bytes))
    }

    fn flush(&mut self) -> std::io::Result<()> {
        std::io::stderr().flush()
    }
}
