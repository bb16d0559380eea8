#pragma once
#include "apps/scene.h"

namespace apps {

/// Declares the keys of the section Output and binds them.
void declare(Schema& schema, Scene::Output& output);

/// Declares the keys of the section Study and binds them.
void declare(Schema& schema, Scene::Study& study);

} // namespace apps
