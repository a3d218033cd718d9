#version 460
#extension GL_GOOGLE_include_directive : require
// GLSL target of the parity test: one invocation a sample; the case is chosen by number.
#include "kernel/glsl.h"
#include "kernel/kernels.inc"
#include "parity/parity.h"

layout(local_size_x = 64) in;
layout(push_constant) uniform Push {
  uint wanted;   // number of the case
  uint samples;  // how many there are
};
layout(std430, set = 0, binding = 0) readonly buffer Inputs { float inputs[]; };     // [8][samples]
layout(std430, set = 0, binding = 1) writeonly buffer Results { float results[]; };  // [4][samples]

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= samples) return;
  float a = inputs[i], b = inputs[samples + i], c = inputs[2u * samples + i], d = inputs[3u * samples + i];
  float e = inputs[4u * samples + i], f = inputs[5u * samples + i], g = inputs[6u * samples + i],
        h = inputs[7u * samples + i];
  vec4 v = vec4(0.0);
  uint number = 0u;
#define PELAGE_PARITY(name, bound, ranges, expression) \
  if (wanted == number++) v = parity_result(expression);
#include "parity/parity_cases.inc"
  results[i] = v.x;
  results[samples + i] = v.y;
  results[2u * samples + i] = v.z;
  results[3u * samples + i] = v.w;
}
