// Linked programs that wait in their context for the next renderer.
#pragma once

#include <cstddef>
#include <deque>
#include <memory>
#include <string>

#include "render/gl/objects.h"

namespace wobblebench::render {

/// Programs of one context that nobody draws with, by their source. A driver that compiles at the
/// first draw, as llvmpipe does, takes longer for a program than for a picture. Uniforms keep the
/// values of the last user: the next one sets all of them.
class ProgramPool {
 public:
  ProgramPool() = default;
  /// The names go with the context.
  ~ProgramPool();
  ProgramPool(const ProgramPool&) = delete;
  ProgramPool& operator=(const ProgramPool&) = delete;

  /// The program that was given back last with this source; empty if there is none.
  GlName<delete_program> take(const std::string& source);
  /// Deletes the one that waits longest if there are too many.
  void give_back(std::string source, GlName<delete_program> program);

 private:
  struct Idle {
    std::string source;
    GlName<delete_program> program;
  };
  std::deque<Idle> idle_;  ///< in the order of their return
};

/// A program that goes back to its pool in the end.
class PooledProgram {
 public:
  PooledProgram() = default;
  PooledProgram(std::shared_ptr<ProgramPool> pool,
                std::string source,
                GlName<delete_program> program);
  PooledProgram(PooledProgram&&) noexcept = default;
  PooledProgram& operator=(PooledProgram&& other) noexcept;
  ~PooledProgram();

  unsigned id() const { return program_.id(); }
  explicit operator bool() const { return bool(program_); }
  const std::string& source() const { return source_; }

 private:
  void give_back();

  std::shared_ptr<ProgramPool> pool_;
  std::string source_;
  GlName<delete_program> program_;
};

/// That of this thread's current context; null without one.
std::shared_ptr<ProgramPool> current_program_pool();

}  // namespace wobblebench::render
