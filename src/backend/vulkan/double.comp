#version 460
// Test program: every value is doubled and raised by a push constant.
layout(local_size_x = 64) in;
layout(push_constant) uniform Push { float offset; };
layout(std430, set = 0, binding = 0) readonly buffer Inputs { float inputs[]; };
layout(std430, set = 0, binding = 1) writeonly buffer Results { float results[]; };
void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i < inputs.length()) results[i] = 2.0 * inputs[i] + offset;
}
