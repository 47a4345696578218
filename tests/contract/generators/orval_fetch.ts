// The fetch client of orval, by a fetch of our own: orval's reads every answer as JSON.
import {createJob, getResult, watchJob} from './generated/orval-fetch/api';
import {at} from './orval_call';
import {namesOf, type Outcome} from './outcome';

export async function unwrap(base: string, mesh: Blob): Promise<Outcome> {
  at(base);
  const sent = await createJob({options: {preset: 'chart'}, mesh});
  if (sent.status !== 202) throw new Error(`status ${sent.status}`);
  const events = await watchJob(sent.data.id);
  const result = await getResult(sent.data.id);
  if (events.status !== 200 || result.status !== 200) throw new Error('no events, or no result');
  return {events: namesOf(events.data), asset: result.data};
}
