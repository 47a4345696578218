// The types of openapi-typescript, used by its companion openapi-fetch.
import createClient from 'openapi-fetch';

import type {components, paths} from './generated/openapi-typescript/api';
import {namesOf, type Outcome} from './outcome';

type Form = {options?: components['schemas']['Options']; mesh: Blob; buffer?: Blob[]};

function formOf(body: Form): FormData {
  const form = new FormData();
  form.append('options', JSON.stringify(body.options ?? {}));
  form.append('mesh', body.mesh);
  return form;
}

export async function unwrap(baseUrl: string, mesh: Blob): Promise<Outcome> {
  const client = createClient<paths>({baseUrl});
  const sent = await client.POST('/v1/jobs', {
    body: {options: {preset: 'chart'}, mesh},
    bodySerializer: (body) => formOf(body as Form),
  });
  if (!sent.data) throw new Error(sent.error.detail);
  const at = {params: {path: {id: sent.data.id}}};
  const events = await client.GET('/v1/jobs/{id}/events', {...at, parseAs: 'text'});
  const result = await client.GET('/v1/jobs/{id}/result', {...at, parseAs: 'blob'});
  if (!events.data || !result.data) throw new Error('no events, or no result');
  return {events: namesOf(events.data), asset: result.data};
}
