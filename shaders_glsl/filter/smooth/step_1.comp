// One layer: filter/smooth/step.glsl.
#define LAYERS 1
#include "filter/smooth/step.glsl"
