// Two layers: filter/smooth/step.glsl.
#define LAYERS 2
#include "filter/smooth/step.glsl"
