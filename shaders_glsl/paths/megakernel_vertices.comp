// paths/megakernel_vertices.glsl, lists alone.
#include "paths/megakernel_vertices.glsl"
