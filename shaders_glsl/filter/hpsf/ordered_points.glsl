// What the passes share that give slots in a fixed order (filter/hpsf/ordered.glsl): the keys, and whose cells are looked for.
#ifndef FILTER_HPSF_ORDERED_POINTS_GLSL
#define FILTER_HPSF_ORDERED_POINTS_GLSL

#include "filter/hpsf/cell.glsl"
#include "filter/hpsf/find.glsl"

layout(set = 1, binding = 3, scalar) buffer Keys { uint at[]; } keys;

#include "filter/hpsf/propose.glsl"

uint key_word(uint at) {
    return keys.at[at];
}

/// The invocation's point; false where it has none. Defined by the kernel.
bool find_point(out CellPoint at);

#endif
