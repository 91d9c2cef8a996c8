//! Properties that hold for whole parts of the program.

mod scene_shared;
