//! Objects of JSON whose members are written once.

use serde::{Serialize, Serializer};

/// An object whose members are found as the program runs; they keep their order.
#[derive(Clone, Debug)]
pub struct Members<N, V>(pub Vec<(N, V)>);

impl<N: Serialize, V: Serialize> Serialize for Members<N, V> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|(name, value)| (name, value)))
    }
}

/// Makes a value that serialises as an object of these members, in their order: a struct literal without its struct.
///
/// ```
/// let (x_m, y_m) = (1.5, 2.0);
/// let place = wildfire_base::object!(Place { name: "a hut", x_m, y_m });
/// assert_eq!(serde_json::to_string(&place).unwrap(), r#"{"name":"a hut","x_m":1.5,"y_m":2.0}"#);
/// ```
#[macro_export]
macro_rules! object {
    ($Name:ident { $($(#[$attribute:meta])* $member:ident $(: $value:expr)?),* $(,)? }) => {{
        #[expect(non_camel_case_types, reason = "each member's type has the member's name")]
        let object = {
            #[derive(serde::Serialize)]
            struct $Name<$($member),*> {
                $($(#[$attribute])* $member: $member),*
            }
            $Name { $($member $(: $value)?),* }
        };
        object
    }};
}
