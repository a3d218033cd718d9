// Uses the installed library through its public headers.
#include <pelage/pelage.h>

#include <cstdio>

int main() {
  pelage::set_thread_count(1);
  std::printf("Pelage %s on %s\n", pelage::version(), pelage::active_isa().c_str());
}
