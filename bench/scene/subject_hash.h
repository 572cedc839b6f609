// Whether a recording is of the scene's subject.
#pragma once

#include <string>

#include "bench/scene/scene.h"
#include "hw/wire/configuration.h"

namespace wobblebench::bench {

/// Hash of all that decides the truth: the section [phantom], with the bytes of an imported file
/// and of a list of scatterers instead of their names, [placement] and [motion]. The scene is that
/// of a ResolvedScene. Options that are without effect on the subject count as their defaults, so
/// that one body has one hash. Throws UserError for a file that is missing, and as read_pieces().
hw::SubjectHash subject_hash(const Scene& scene);

/// Throws UserError "SOURCE: …" naming the first section in which the scene differs from the
/// recorded subject; a subject that is not stated differs in none. Older recordings, whose hash
/// holds options without effect too, are those of a scene that has the same. `placed`: the scene is
/// that of a ResolvedScene; before that only a position that the scene gives is compared.
void refuse_other_subject(const Scene& scene,
                          const hw::SubjectHash& recorded,
                          bool placed,
                          const std::string& source);

}  // namespace wobblebench::bench
