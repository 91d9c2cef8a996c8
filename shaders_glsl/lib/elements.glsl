// Kernels over elements instead of pixels, in workgroups of one dimension; rows of workgroups where a device takes no more in one.
#ifndef LIB_ELEMENTS_GLSL
#define LIB_ELEMENTS_GLSL

/// Number of this invocation's element; invocations beyond the last one have none.
uint element_index() {
    return gl_GlobalInvocationID.x + gl_GlobalInvocationID.y * gl_NumWorkGroups.x * gl_WorkGroupSize.x;
}

#endif
