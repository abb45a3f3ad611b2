// SPDX-License-Identifier: Apache-2.0
#include "core/trace/photon_segments.h"
#include "core/trace/photon_wave.h"

namespace lightloom {

bool traceSegments(const RayScene& rays, const LightSampler& lights, const PhotonJob& job, std::uint64_t first,
                   std::span<SegmentBlock> blocks, Workers& workers, const std::stop_token& stop)
{
    const std::uint64_t stream = rays.scene().groups[static_cast<std::size_t>(job.group)].key();
    const std::uint64_t streamKey = Rng::streamKey(job.seed, stream);
    return workers.run(blocks.size(), stop, [&](std::size_t b) {
        SegmentBlock& result = blocks[b];
        result.segments.clear();
        const std::uint64_t begin = (first + b) * kSegmentBlock, end = std::min(job.count, begin + kSegmentBlock);
        PhotonBlock block{rays, lights, job, streamKey, 1.0f / static_cast<float>(job.count)};
        block.segments = &result.segments;
        block.makeRoom(static_cast<std::size_t>(end - begin));
        PhotonWave(block, begin, end).trace();
        result.counts = {job.group, end - begin, block.rayCount, block.caustic, block.cutOff, block.ledger, {}};
        result.stored = block.stored;
    });
}

} // namespace lightloom
