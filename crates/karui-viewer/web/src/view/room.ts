// Something for metals to mirror: without surroundings they are black.

import { Mesh, type MeshStandardMaterial, type Object3D, PMREMGenerator, type Scene, type Texture, type WebGLRenderer } from 'three';
import { RoomEnvironment } from 'three/addons/environments/RoomEnvironment.js';

const rooms = new WeakMap<WebGLRenderer, Texture>();

/** Whether something below a root mirrors. */
export function mirrors(root: Object3D): boolean {
  let found = false;
  root.traverse((object) => {
    if (!(object instanceof Mesh)) return;
    for (const material of [object.material].flat() as MeshStandardMaterial[]) {
      found ||= (material.metalness ?? 0) > 0.2;
    }
  });
  return found;
}

/** Puts a scene into a room; the first one takes a while. */
export function surround(scene: Scene, renderer: WebGLRenderer): void {
  let room = rooms.get(renderer);
  if (!room) {
    const generator = new PMREMGenerator(renderer);
    room = generator.fromScene(new RoomEnvironment(), 0.04).texture;
    generator.dispose();
    rooms.set(renderer, room);
  }
  scene.environment = room;
  scene.environmentIntensity = 0.55;
}
