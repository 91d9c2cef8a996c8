// Numbers that every room of the house uses.
#ifndef LIB_CONSTANTS_GLSL
#define LIB_CONSTANTS_GLSL

const float PI = 3.14159265358979;
const float INV_PI = 0.318309886183791;

/// A distance beyond every scene, in metres. Not infinity: drivers may assume that there is none.
const float FAR_AWAY = 1e30;

#endif
