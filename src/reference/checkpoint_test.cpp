#include "reference/checkpoint.h"

#include <gtest/gtest.h>
#include <pelage/error.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "core/rng.h"

namespace pelage {
namespace {

Film some_film(int samples) {
  Film film(20, 10, true, false);
  Rng rng(1, static_cast<std::uint32_t>(samples));
  for (std::size_t p = 0; p < film.pixels.size(); ++p)
    for (int i = 0; i < samples; ++i) {
      PathSample s;
      s.radiance = {rng.uniform(), rng.uniform(), rng.uniform()};
      add_sample(film, p, s);
    }
  film.seconds = samples;
  return film;
}

bool same(const Film& a, const Film& b) {
  return a.seconds == b.seconds && std::memcmp(a.pixels.data(), b.pixels.data(), a.pixels.size() * sizeof(FilmPixel)) == 0 &&
         a.bounces == b.bounces;
}

std::string message_of(const std::string& path, std::uint64_t mark, Film film) {
  try {
    read_checkpoint(path, mark, film);
  } catch (const Error& e) {
    return e.what();
  }
  return "";
}

class Checkpoint : public testing::Test {
 protected:
  Checkpoint() { std::filesystem::create_directories(folder_); }
  ~Checkpoint() override { std::filesystem::remove_all(folder_); }
  std::filesystem::path folder_ = testing::TempDir() + "pelage_checkpoint_" + std::to_string(getpid());
  std::string path_ = folder_ / "state";
};

TEST_F(Checkpoint, GivesBackWhatWasWritten) {
  const Film film = some_film(3);
  write_checkpoint(path_, film, 42);
  Film found(20, 10, true, false);
  EXPECT_TRUE(read_checkpoint(path_, 42, found));
  EXPECT_TRUE(same(film, found));
}

TEST_F(Checkpoint, AMissingFileIsNoCheckpoint) {
  Film film(20, 10, true, false);
  EXPECT_FALSE(read_checkpoint(path_, 42, film));
}

TEST_F(Checkpoint, RefusesTheStateOfAnotherPicture) {
  write_checkpoint(path_, some_film(1), 42);
  EXPECT_NE(message_of(path_, 43, Film(20, 10, true, false)).find("another picture"), std::string::npos);
  EXPECT_NE(message_of(path_, 42, Film(20, 10, false, false)).find("another picture"), std::string::npos);
  EXPECT_NE(message_of(path_, 42, Film(10, 20, true, false)).find("20 × 10 pixels"), std::string::npos);
}

TEST_F(Checkpoint, EveryTruncationAndEveryDamagedByteIsAnError) {
  write_checkpoint(path_, some_film(1), 42);
  std::ifstream in(path_, std::ios::binary);
  const std::string whole((std::istreambuf_iterator<char>(in)), {});
  const Film expected(20, 10, true, false);
  const auto put = [&](const std::string& bytes) { std::ofstream(path_, std::ios::binary) << bytes; };
  for (std::size_t size = 0; size < whole.size(); size += size < 200 ? 1 : 997) {
    put(whole.substr(0, size));
    EXPECT_NE(message_of(path_, 42, expected), "") << size;
  }
  for (std::size_t at = 0; at < whole.size(); at += at < 200 ? 1 : 991) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x10);
    put(damaged);
    EXPECT_NE(message_of(path_, 42, expected), "") << at;
  }
}

// A child writes two states in turn and is killed at some moment; what stands there is one of them.
TEST_F(Checkpoint, KilledAtAnyMomentTheFileIsTheOldOrTheNewOne) {
  const Film a = some_film(1), b = some_film(2);
  write_checkpoint(path_, a, 42);
  Rng rng(9, 9);
  for (int round = 0; round < 40; ++round) {
    const pid_t child = fork();
    ASSERT_GE(child, 0);
    if (child == 0)
      for (;;) write_checkpoint(path_, b, 42), write_checkpoint(path_, a, 42);
    usleep(static_cast<useconds_t>(500 + 8000 * rng.uniform()));
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
    Film found(20, 10, true, false);
    ASSERT_TRUE(read_checkpoint(path_, 42, found)) << round;
    ASSERT_TRUE(same(found, a) || same(found, b)) << round;
  }
}

TEST(Fingerprint, ChangesWithWhatIsSeenAndNotWithWhenToStop) {
  Scene scene;
  scene.lights.emplace_back();
  TraceSettings settings;
  const std::uint64_t mark = fingerprint(scene, settings);
  settings.samples = 1000, settings.seconds = 3, settings.noise = 0.1f, settings.checkpoint = std::string(1, 'x');
  scene.settings.exposure = 2;
  EXPECT_EQ(fingerprint(scene, settings), mark);
  settings.seed = 1;
  EXPECT_NE(fingerprint(scene, settings), mark);
  settings.seed = 0;
  scene.lights[0].intensity.y = 0.5f;
  EXPECT_NE(fingerprint(scene, settings), mark);
  scene.lights[0].intensity.y = 1;
  EXPECT_EQ(fingerprint(scene, settings), mark);
  scene.grooms.emplace_back().material.artist.trt.width += 0.1f;
  const std::uint64_t with_groom = fingerprint(scene, settings);
  scene.grooms.back().material.artist.trt.width -= 0.1f;
  EXPECT_NE(fingerprint(scene, settings), with_groom);
  scene.grooms.clear();
  scene.camera.fov_y += 0.01f;
  EXPECT_NE(fingerprint(scene, settings), mark);
}

}  // namespace
}  // namespace pelage
