// The GL state that a program which shares its context with the renderer set up.
#pragma once

#include <array>
#include <cstddef>

namespace wobblebench::render {

/// Texture units that programs bind textures to: 0 and following.
inline constexpr int kTextureUnits = 5;
/// Draw buffers of a framebuffer: the least that OpenGL guarantees.
inline constexpr int kDrawBuffers = 8;

/// While it exists, the state of the current context that changes what a draw, an upload or a
/// download of this folder does has the value that they need; its end restores the host's. The
/// state is that of OpenGL 4.5 core (render/renderer.h lists it): OpenGL has no call for all of it.
/// Errors that the host left are dropped. Throws ContextLost.
class HostState {
 public:
  HostState();
  ~HostState();
  HostState(const HostState&) = delete;
  HostState& operator=(const HostState&) = delete;

 private:
  static constexpr std::size_t kSwitches = 27;
  static constexpr std::size_t kPixelStores = 16;

  /// Bindings of a texture unit.
  struct Unit {
    std::array<int, 3> textures;  ///< 2D, 3D, 2D array
    int sampler;
  };
  struct Rectangle {
    std::array<float, 4> viewport;
    std::array<int, 4> scissor;
    bool is_scissored;
  };

  void save_bindings();
  void restore_bindings() const;
  void clear_switches();
  void restore_switches() const;
  void clear_draw_buffers();
  void restore_draw_buffers() const;
  void clear_pixel_stores();
  void restore_pixel_stores() const;
  void clear_rasterizer();
  void restore_rasterizer() const;
  void pause_transform_feedback();

  std::array<bool, kSwitches> switches_{};
  std::array<int, kPixelStores> pixel_stores_{};
  std::array<bool, kDrawBuffers> blends_{};
  std::array<std::array<unsigned char, 4>, kDrawBuffers> color_masks_{};
  std::array<Unit, kTextureUnits> units_{};
  Rectangle rectangle_{};
  std::array<int, 2> polygon_mode_{};
  std::array<int, 2> clip_control_{};
  int active_texture_ = 0;
  int draw_framebuffer_ = 0;
  int read_framebuffer_ = 0;
  int vertex_array_ = 0;
  int program_ = 0;
  int unpack_buffer_ = 0;
  int pack_buffer_ = 0;
  bool paused_transform_feedback_ = false;
};

}  // namespace wobblebench::render
