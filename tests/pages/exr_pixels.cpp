// exr_pixels FILE.exr COLUMN ROW [COLUMN ROW…]: prints the first channel there, one value a line,
// or "null" of NaN.
#include <OpenImageIO/imageio.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>

int main(int argc, char** argv) {
  if (argc < 4 || argc % 2 != 0) return EXIT_FAILURE;
  const auto file = OIIO::ImageInput::open(argv[1]);
  if (!file) return EXIT_FAILURE;
  const auto width = static_cast<std::size_t>(file->spec().width);
  std::vector<float> values(width * static_cast<std::size_t>(file->spec().height));
  if (!file->read_image(0, 0, 0, 1, OIIO::TypeFloat, values.data())) return EXIT_FAILURE;
  for (int i = 2; i < argc; i += 2) {
    const std::size_t index =
        std::strtoul(argv[i + 1], nullptr, 10) * width + std::strtoul(argv[i], nullptr, 10);
    if (index >= values.size()) return EXIT_FAILURE;
    if (std::isfinite(values[index])) {
      std::printf("%.9g\n", static_cast<double>(values[index]));
    } else {
      std::puts("null");
    }
  }
}
