// The client of @hey-api/openapi-ts.
import {client} from './generated/hey-api/client.gen';
import {createJob, getResult, watchJob} from './generated/hey-api/sdk.gen';
import type {Outcome} from './outcome';

export async function unwrap(baseUrl: string, mesh: Blob): Promise<Outcome> {
  client.setConfig({baseUrl});
  const {data: job} = await createJob({body: {options: {preset: 'chart'}, mesh}, throwOnError: true});
  const events: string[] = [];
  const {stream} = await watchJob({
    path: {id: job.id},
    onSseEvent: ({event}) => events.push(event ?? ''),
  });
  for await (const data of stream) if (!data) throw new Error('an event without data');
  const {data: asset} = await getResult({path: {id: job.id}, parseAs: 'blob', throwOnError: true});
  return {events, asset};
}
