// What a backend implements: a context of its driver.
#pragma once

#include <atomic>
#include <memory>
#include <string>

#include "render/gl/program_pool.h"

namespace wobblebench::render {

/// A driver's context. A thread on which it is current shares its ownership
/// (render/gl/context.cpp), so that it is destroyed only where, and when, no thread has it current.
class DriverContext {
 public:
  virtual ~DriverContext() = default;
  DriverContext() = default;
  DriverContext(const DriverContext&) = delete;
  DriverContext& operator=(const DriverContext&) = delete;

  /// Makes it this thread's current context. Throws std::runtime_error; ContextLost.
  virtual void bind() = 0;
  /// Leaves this thread without a context.
  virtual void unbind() = 0;
  /// Address of a GL function.
  virtual void* proc_address(const char* name) const = 0;
  /// Name that make_context takes.
  virtual std::string backend() const = 0;

  std::atomic<bool> is_current{false};  ///< on some thread
  const std::shared_ptr<ProgramPool> programs = std::make_shared<ProgramPool>();
};

}  // namespace wobblebench::render
