#include "render/gl/program_pool.h"

#include <algorithm>
#include <utility>

namespace wobblebench::render {

namespace {

/// A renderer has a dozen; these are those of some ten settings.
constexpr std::size_t kMostIdle = 128;

}  // namespace

ProgramPool::~ProgramPool() {
  for (Idle& idle : idle_) idle.program.release();
}

GlName<delete_program> ProgramPool::take(const std::string& source) {
  const auto found = std::find_if(
      idle_.rbegin(), idle_.rend(), [&](const Idle& idle) { return idle.source == source; });
  if (found == idle_.rend()) return {};
  GlName<delete_program> program = std::move(found->program);
  idle_.erase(std::next(found).base());
  return program;
}

void ProgramPool::give_back(std::string source, GlName<delete_program> program) {
  idle_.push_back({std::move(source), std::move(program)});
  if (idle_.size() > kMostIdle) idle_.pop_front();
}

PooledProgram::PooledProgram(std::shared_ptr<ProgramPool> pool,
                             std::string source,
                             GlName<delete_program> program)
    : pool_(std::move(pool)), source_(std::move(source)), program_(std::move(program)) {}

PooledProgram& PooledProgram::operator=(PooledProgram&& other) noexcept {
  if (this == &other) return *this;
  give_back();
  pool_ = std::move(other.pool_);
  source_ = std::move(other.source_);
  program_ = std::move(other.program_);
  return *this;
}

PooledProgram::~PooledProgram() {
  give_back();
}

void PooledProgram::give_back() {
  if (pool_ && program_) pool_->give_back(std::move(source_), std::move(program_));
}

}  // namespace wobblebench::render
