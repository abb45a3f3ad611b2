// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/scene/scene.h"

/// Scenes whose light is known exactly (METHODS section 8), for tests and for anyone who doubts us. Grey throughout:
/// all channels are equal. E is illuminance (lux), M exitance without reflection (lm/m2), B = rho E + M, I candela.
namespace lightloom {

/// The formulas are usually written with +z up. Their point (x, y, z) is our `fromZUp(x, y, z)`: the axes turn
/// cyclically (z up becomes y up, x becomes z, y becomes x), so coordinates keep their values and nothing is mirrored.
[[nodiscard]] inline glm::vec3 fromZUp(float x, float y, float z) { return {y, z, x}; }

/// Furnace: a closed box `size` centred at the origin whose inside emits M and reflects rho everywhere. At every point
/// direct E = M, total E = B = M / (1 - rho), indirect E = M rho / (1 - rho).
[[nodiscard]] Scene furnaceBox(float rho, float exitance = 1.0f, glm::vec3 size = glm::vec3(2.0f));

/// Cube of half edge 1 around a point light of I candela at the origin, all faces rho. On a face at (u, v) from its
/// middle direct E = I / (1 + u2 + v2)^1.5. Flux 4 pi I, area 24: mean indirect E = 4 pi I rho / (24 (1 - rho)).
[[nodiscard]] Scene litCube(float rho, float candela = 100.0f);

/// Black room 4 x 4 x 3 (z up), corner at the origin, isotropic source of 1000 cd at (2, 2, 2.9). E = I cos / d^2
/// everywhere, indirect 0; flux on a face = I times its solid angle; 4000 pi lm in all.
[[nodiscard]] Scene pointSourceRoom();

/// The same black room with a 1 x 1 m Lambertian panel flush in the middle of the ceiling, M = 10000 lm/m2, facing
/// down. E = M times the configuration factor of the square (Lambert's contour formula); 10000 lm in all.
[[nodiscard]] Scene areaSourceRoom();

/// Reflection: a plane S2, side x side, x in [-side/2, side/2], y in [0, side], z = 0 (z up), reflecting rho, lit by a
/// sun straight from above with `lux`; a black wall above its edge y = 0, facing +y, 4 m high and as wide as S2 is.
/// The sun grazes the wall, so its direct E is 0; its indirect E = rho lux times the configuration factor of S2.
/// S2 gets no indirect light. In mid-air, facing down, the same holds.
[[nodiscard]] Scene reflectionScene(float side, float rho = 0.5f, float lux = 1000.0f);

/// The reflection scene with side 4 and a black screen standing at y = 1, x in [-10, 10], z in [0, 0.5]: only what a
/// wall point sees of S2 over and before the screen counts. The screen is parallel to the sun and shades nothing.
[[nodiscard]] Scene obstructionScene(float rho = 0.5f, float lux = 1000.0f);

/// Two square plates `side` wide, `gap` apart, facing each other: the lower (y = 0) emits M and reflects rhoLow, the
/// upper reflects rhoHigh. For side / gap to infinity B_low = M / (1 - rhoLow rhoHigh), B_high = rhoHigh B_low; in the
/// middle of the default plates the open rim takes less than gap^2 / (side / 2)^2 = 1e-4 of each bounce.
[[nodiscard]] Scene parallelPlates(float rhoLow, float rhoHigh, float exitance = 1.0f, float side = 200.0f,
                                   float gap = 1.0f);

/// Sphere of radius rInner that faces out, emits M and reflects rhoInner, inside one of rOuter that faces in and
/// reflects rhoOuter. With k = A_inner / A_outer: B_in = M / (1 - rhoInner rhoOuter k / (1 - rhoOuter (1 - k))),
/// B_out = rhoOuter k B_in / (1 - rhoOuter (1 - k)). Both are facetted (64 rings, .1 % of area missing from each): k
/// from true areas and from radii agree, pointwise values hold to about a percent.
[[nodiscard]] Scene concentricSpheres(float rhoInner, float rhoOuter, float exitance = 1.0f, float rInner = 0.5f,
                                      float rOuter = 1.0f);

/// Closed cavity, every face rho, with a point source of `flux` lumen: mean over all area of direct E = flux / A, of
/// indirect E = flux rho / (A (1 - rho)), whatever the shape. `cavityCube` is 4 m wide (A = 96 m2), the source off the
/// middle; `cavityL` is an L of 3 m height on 12 m2 of floor (A = 72 m2) with the source in one arm, not convex.
[[nodiscard]] Scene cavityCube(float rho, float flux = 1000.0f);
[[nodiscard]] Scene cavityL(float rho, float flux = 1000.0f);

} // namespace lightloom
