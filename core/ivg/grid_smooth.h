// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "core/ivg/grid_fit.h"

namespace lightloom {

inline constexpr double kSmoothBytesPerVertex = 220.0; ///< while it is done

/// Takes noise out of a grid's light where the light around does not contradict: a vertex's value of a direction is
/// drawn towards the mean of its neighbours in the plane that faces this direction. How far is what the noise says
/// (empirical Bayes; Lee 1980): with b^2 what values miss of such means beyond their noise, pooled over the
/// neighbours, and s^2, m^2 the variances of the value and of the mean, the value keeps
///
///   k = (b^2 + m^2) / (b^2 + m^2 + s^2)
///
/// of itself. So smooth light loses most of its noise, edges that the photons tell apart stay, and more photons mean
/// less smoothing. Neighbours come in opposite pairs, both in sight, so that light which grows in step is not changed,
/// beside walls neither. Twice: with the neighbours, then with those two cells away. Each light group alone, colours
/// by what its luminance says. Photons of a plane cross one of its faces each, so that values there err
/// independently.
///
/// `layer` gets new vectors and the variance of these, stated so that a lookup's noise is right: neighbours err
/// together now.
void smoothVectors(const GridGeometry& geometry, GridEstimator estimator, GridLayer& layer, Workers& workers);

/// The same for what surface is told, vectors and `fit`: `layer` gets the fit, smoothed, and its variance where there
/// is one.
void smoothFit(const GridGeometry& geometry, GridEstimator estimator, const SurfaceFit& fit, GridLayer& layer,
               Workers& workers);

} // namespace lightloom
