// SPDX-License-Identifier: Apache-2.0
// Limits that shaders and C++ must agree on.
const int kMostLamps = 16;         // lamps the preview of direct light can hold
const int kMostSampleLights = 128; // of all lamps together; an emissive surface counts up to kMostPerSurface
const int kMostPerSurface = 8;
const int kMostVdls = 8;           // virtual directional lights of one octree entry
const int kLampPoint = 0;
const int kLampSpot = 1;
const int kLampSun = 2;
const int kLampSurface = 3;
const int kToneNone = 0;           // values above white are cut off
const int kToneSoft = 1;           // straight up to 0.7, then a shoulder
const float kCompatible = 0.3f;    // cosine beyond which an octree entry answers for a receiver
const float kBeyondCounts = 1e-5f; // what an entry's answer counts beyond a wall: nothing, if there is another
const float kMirrorsBelow = 0.35f;  // roughness up to which a metal with an environment map mirrors it
const float kLeastGloss = 0.1f;    // GGX alpha: a few virtual lights cannot make a sharper reflection
