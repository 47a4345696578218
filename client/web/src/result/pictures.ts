// The server's pictures of a result, where the browser cannot draw the views.
import {$, show} from '../base/dom.js';
import {getBlob} from '../job/server.js';
import type {Kept} from './downloads.js';
import {ofLambda} from './load.js';

export async function showPictures({job: {links}, lambda}: Kept): Promise<void> {
  const pictures = [['preview-picture', links.preview], ['layout-picture', links.layout_png]] as const;
  await Promise.all(pictures.map(async ([id, link]) => {
    const url = URL.createObjectURL(await getBlob(link + ofLambda(lambda)));
    const image = $<HTMLImageElement>(id);
    image.src = url;
    await image.decode();
    URL.revokeObjectURL(url);
  }));
  show($('pictures'), true);
}
