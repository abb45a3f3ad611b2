// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/scene/gltf_reader.h"
#include "tests/gltf_builder.h"
#include <QtGlobal>

/// What tests of the glTF reader share.
namespace lightloom::test {

/// The scene in `file`; null, and the reason in the test's log, where it was refused.
inline std::shared_ptr<const Scene> read(GltfBuilder& file)
{
    const auto scene = readScene(file.glb(), ".");
    if (scene) return *scene;
    qWarning("%s", scene.error().message.c_str());
    return nullptr;
}

/// Whether exactly one of the scene's warnings holds `part`.
inline bool warns(const Scene& scene, const char* part)
{
    return std::count_if(scene.warnings.begin(), scene.warnings.end(),
                         [&](const std::string& line) { return line.find(part) != std::string::npos; }) == 1;
}

} // namespace lightloom::test
