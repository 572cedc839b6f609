// Texel formats and filters of textures.
#pragma once

namespace wobblebench::render {

enum class TexelFormat { r8, r16, r32f, rg8, rg16, rg32f, rgba8, rgba16, rgb32f, rgba32f };
enum class TextureFilter { nearest, linear };

}  // namespace wobblebench::render
