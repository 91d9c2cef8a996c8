//! `pathspace report`, from results to what a browser shows.

mod browser;
mod command;
mod results;
