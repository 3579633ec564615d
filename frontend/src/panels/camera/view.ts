import type { SceneView } from '../../api';

/** Where each view begins. */
export const VIEWS: Record<SceneView['name'], SceneView> = {
  follow: { name: 'follow', azimuth: -28, elevation: 16, distance: 1.1 },
  side: { name: 'side', azimuth: 90, elevation: 4, distance: 1.1 },
  top: { name: 'top', azimuth: 0, elevation: 89, distance: 1.8 },
};
const LOW = -60;
const HIGH = 89;
const NEAR = 0.4;
const FAR = 15;

/** The view turned by so many degrees; azimuths stay within -180 to 180. */
export function turned(view: SceneView, right: number, up: number): SceneView {
  const azimuth = ((((view.azimuth + right + 180) % 360) + 360) % 360) - 180;
  return { ...view, azimuth, elevation: Math.min(HIGH, Math.max(LOW, view.elevation + up)) };
}

/** The view from `times` as far away. */
export function moved(view: SceneView, times: number): SceneView {
  return { ...view, distance: Math.min(FAR, Math.max(NEAR, view.distance * times)) };
}
