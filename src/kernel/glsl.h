// GLSL target of the shared kernel source (compute shaders include this first; glslc -I src).
// Include kernel headers afterwards, in the order of kernels.inc.
#ifndef PELAGE_KERNEL_GLSL_H_
#define PELAGE_KERNEL_GLSL_H_

#define PELAGE_FN
#define PELAGE_EXACT precise  // no contraction, no reassociation: for sums that cancel on purpose
#define Float float
#define Mask bool
#define Vec2 vec2
#define Vec3 vec3
#define Vec4 vec4
// Names that only GLSL reserves.
#define flat flat_
#define half half_
#define sample sample_

float select(bool m, float a, float b) { return m ? a : b; }
vec2 select(bool m, vec2 a, vec2 b) { return m ? a : b; }
vec3 select(bool m, vec3 a, vec3 b) { return m ? a : b; }
float pow2i(float n) { return intBitsToFloat((int(n) + 127) << 23); }
float exponent_of(float x) { return float(int(floatBitsToUint(x) >> 23) - 127); }
float mantissa_of(float x) { return uintBitsToFloat((floatBitsToUint(x) & 0x007fffffu) | 0x3f800000u); }

#endif
