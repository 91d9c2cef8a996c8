// paths/wavefront/connect.glsl, the terms summed up.
#include "paths/wavefront/connect.glsl"
