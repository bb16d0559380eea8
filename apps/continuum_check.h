#pragma once
#include "apps/findings.h"
#include "apps/scene.h"

namespace apps {

/// What the sections of a continuum say that cannot be, alone or with the rest of the scene.
void check_continuum(const Scene& scene, Findings& findings);

} // namespace apps
