// Three layers: filter/smooth/step.glsl.
#define LAYERS 3
#include "filter/smooth/step.glsl"
