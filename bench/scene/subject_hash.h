// Whether a recording is of the scene's subject.
#pragma once

#include <string>

#include "bench/scene/scene.h"
#include "hw/wire/configuration.h"

namespace wobblebench::bench {

/// Of all that decides the truth: the section [phantom] and the bytes of an imported file and of a
/// list of scatterers in the place of their names, [placement], [motion]. After
/// complete_from_phantom(). Throws UserError for a file that cannot be read.
hw::SubjectHash subject_hash(const Scene& scene);

/// Throws UserError "SOURCE: …" naming the first section in which the scene differs from the
/// recorded subject; a subject that is not stated differs in none. `placed`: the scene's position
/// is known, after complete_from_phantom(); before it only a position that the scene gives is
/// compared.
void refuse_other_subject(const Scene& scene,
                          const hw::SubjectHash& recorded,
                          bool placed,
                          const std::string& source);

}  // namespace wobblebench::bench
