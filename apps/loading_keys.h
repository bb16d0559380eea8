#pragma once
#include "apps/scene.h"

namespace apps {

/// Declares the keys of the section Loading.
void declare_loading(Schema& schema, Scene::Load& load);

} // namespace apps
