// What is seen through the texture coordinates: a checkerboard, or an image of the person's own.
import {CanvasTexture, LinearMipmapLinearFilter, RepeatWrapping, SRGBColorSpace, type Texture, TextureLoader} from 'three';

const SQUARES = 32;

function prepared<T extends Texture>(texture: T): T {
  texture.wrapS = texture.wrapT = RepeatWrapping;
  texture.colorSpace = SRGBColorSpace;
  texture.minFilter = LinearMipmapLinearFilter;
  texture.anisotropy = 8;
  return texture;
}

/** Squares of a page, each eighth of it in a tint of its own and with a letter and a number. */
export function checkerboard(): Texture {
  const canvas = document.createElement('canvas');
  canvas.width = canvas.height = 1024;
  const pen = canvas.getContext('2d')!;
  const side = canvas.width / SQUARES;
  for (let y = 0; y < SQUARES; y += 1)
    for (let x = 0; x < SQUARES; x += 1) {
      const hue = (Math.floor(x / 4) * 45 + Math.floor(y / 4) * 23) % 360;
      pen.fillStyle = `hsl(${hue} 45% ${(x + y) % 2 ? 88 : 58}%)`;
      pen.fillRect(x * side, y * side, side, side);
    }
  pen.font = `bold ${side * 1.2}px sans-serif`;
  pen.textAlign = 'center';
  pen.textBaseline = 'middle';
  pen.fillStyle = '#1a1a1a';
  for (let y = 0; y < 8; y += 1)
    for (let x = 0; x < 8; x += 1) pen.fillText(`${'ABCDEFGH'[x]}${8 - y}`, (4 * x + 2) * side, (4 * y + 2) * side);
  return prepared(new CanvasTexture(canvas));
}

/** Throws what the browser says of a file that is no image. */
export async function imageTexture(file: Blob): Promise<Texture> {
  const url = URL.createObjectURL(file);
  try {
    return prepared(await new TextureLoader().loadAsync(url));
  } catch {
    throw new Error('This file is not an image that the browser can show. Choose a PNG, JPEG or WebP.');
  } finally {
    URL.revokeObjectURL(url);
  }
}
