//! Input that is wrong, extreme or hostile.

mod scene_malformed;
