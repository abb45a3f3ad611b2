// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/base/units.h"
#include "core/compare/probes.h"
#include "core/params/param_text.h"
#include "core/photonmap/photon_products.h"
#include "core/trace/reference.h"
#include <charconv>
#include <cstring>
#include <fmt/format.h>
#include <optional>
#include <string>
#include <vector>

namespace lightloom {

/// What benches of accuracy are told: [--probes N] [--paths N] [--set NAME=VALUE ...] [SCENE[:TRIANGLES] ...]
struct JudgeSettings {
    int probes = 1000, paths = 4096;
    BakeParams params;
    std::vector<std::string> words; ///< whatever else was said, scenes as a rule

    /// Nothing: bad input, which was told.
    static std::optional<JudgeSettings> read(int argc, char** argv)
    {
        JudgeSettings settings;
        for (int i = 1; i < argc; ++i) {
            const std::string word = argv[i];
            const char* value = i + 1 < argc ? argv[i + 1] : "";
            if (word == "--probes" || word == "--paths") {
                std::from_chars(value, value + std::strlen(value),
                                word == "--probes" ? settings.probes : settings.paths);
                ++i;
            } else if (word == "--set") {
                const Result<BakeParams> params = withAssignment(settings.params, value);
                if (!params) return fmt::print("{}\n", params.error().message), std::nullopt;
                settings.params = *params;
                ++i;
            } else {
                settings.words.push_back(word);
            }
        }
        return settings;
    }
};

/// Probes that are area-uniform over reached surface (seed 1), and the reference's indirect luminance at them.
struct Judge {
    std::vector<SurfacePoint> surface;
    std::vector<ProbePoint> points;
    std::vector<double> reference;
    std::vector<glm::vec3> noise; ///< the reference's own standard errors

    Judge(const SceneProducts& at, const JudgeSettings& settings, Workers& workers)
        : surface(samplePoints(*at.rays, *at.lights, *at.reach, static_cast<std::uint64_t>(settings.probes), 1))
    {
        std::uint64_t stream = 0;
        for (const SurfacePoint& p : surface) points.push_back({p.position, p.normal, stream++});
        ReferenceJob job;
        job.paths = settings.paths;
        for (const ProbeLight& light :
             referenceIlluminance(*at.rays, *at.lights, {}, points, job, workers, {}).probes) {
            reference.push_back(static_cast<double>(luminance(light.indirect)));
            noise.push_back(light.indirectError);
        }
    }
};

} // namespace lightloom
