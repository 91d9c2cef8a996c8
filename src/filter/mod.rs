//! Filters of the radiance behind the filter vertex (paths::terms::Terms), each in a file or folder of its name.

pub mod anhpsf;
pub mod hpsf;
pub mod nhpsf;
pub mod smooth;
pub mod sspsf;
